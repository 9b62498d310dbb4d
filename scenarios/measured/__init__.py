"""What was measured: tables and logs with roles, the card, and checks of both."""
