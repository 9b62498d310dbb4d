"""What the user reads: findings as data, words, pages, and the extended rig."""
