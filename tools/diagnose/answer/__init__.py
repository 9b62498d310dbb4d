"""From probabilities to answers: decision, sets, gain, design of the next experiment."""
