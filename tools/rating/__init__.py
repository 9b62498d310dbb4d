"""Reference methods beside the model: losses, sump temperature and thermal rating after ISO/TR 14179."""
