"""From residuals to probabilities: one vector, its fit, its evidence, the search and the alarm."""
