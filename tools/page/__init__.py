"""The machine itself in one page: its model as WebAssembly, and what moves it."""
