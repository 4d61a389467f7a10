"""What is searched: swings, which are fitted and which held out, and the noise on them."""
