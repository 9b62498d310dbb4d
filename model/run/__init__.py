"""What is done with a flat model: schedules, transients, steady states, design, results."""
