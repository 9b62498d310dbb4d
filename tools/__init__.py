"""Rooms by what a user does; `gearheat` itself and the command line call them."""
