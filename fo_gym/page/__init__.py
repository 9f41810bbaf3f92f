"""The leaderboard as a page to look at, built from what the leaderboard published: it comes last and changes nothing."""
