"""Block diagrams as pictures: from live diagrams and plants to SVG."""
