"""What may be wrong: causes, sensors' faults and nuisances, one file a family."""
