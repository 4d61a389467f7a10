"""What a swing says of itself: half-swings and releases, clocks and gaps, spikes and slips, and its noise."""
