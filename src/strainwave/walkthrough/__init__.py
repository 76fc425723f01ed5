"""The main job on a simulated joint: recorded, identified, filtered, and compared with the truth."""
