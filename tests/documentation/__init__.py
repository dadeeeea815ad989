"""What the documentation says is run: its commands, its Python, its links."""
