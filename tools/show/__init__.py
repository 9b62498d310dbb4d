"""Tables, pictures and pages of numbers: nothing here solves anything."""
