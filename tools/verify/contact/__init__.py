"""The contact solver beside published films, Hertz, measurements and another solver."""
