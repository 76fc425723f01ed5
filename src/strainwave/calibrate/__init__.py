"""From measurements to the numbers of a joint: fitting, apart from applying, storing and drawing."""
