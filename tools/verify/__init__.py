"""Published numbers beside what the model gives, machines, laws and the contact solver."""
