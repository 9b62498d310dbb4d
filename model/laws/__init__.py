"""Pure cited functions, one formula of one source each."""
