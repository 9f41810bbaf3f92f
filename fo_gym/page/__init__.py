"""The leaderboard as a page to look at, built from what was published: it comes last and changes nothing."""
