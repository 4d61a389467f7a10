"""What could be added, exchanged or left out, and its fit."""
