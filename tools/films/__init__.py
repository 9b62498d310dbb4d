"""Films of one contact over load, speed and temperature, and the law fitted to them."""
