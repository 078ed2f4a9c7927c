"""One file a scene: parameters, truth, our run, the engines' runs, the tolerance, and what it leaves out."""
