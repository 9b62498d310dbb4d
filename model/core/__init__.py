"""The acausal machinery: declarations, connections, flattening. Knows no physics."""
