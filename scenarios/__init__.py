"""Rig files, catalogues and measured tables, read and checked."""
