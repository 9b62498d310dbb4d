"""What the contact solver gives beside what is known: verification table, figures, mesh cycle, a peer program."""
