"""What the workflow asks before it starts: settings, the plan of recordings, and which files a script rests on."""
