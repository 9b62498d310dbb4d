"""What there is: rigs, catalogues, part types, and what one rig is made of."""
