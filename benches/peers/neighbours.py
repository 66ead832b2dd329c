"""scikit-learn on the exported points: five neighbours of each query, and the class that most have."""

import numpy as np
from sklearn.neighbors import KNeighborsClassifier

from common import array, measure, tell


def main():
    points, classes = array("labelled.f64", "f8", -1, 3), array("labelled.u8", "u1")
    queries, ours = array("queries.f64", "f8", -1, 3), array("queries.u8", "u1")
    model = KNeighborsClassifier(n_neighbors=5, algorithm="kd_tree", n_jobs=1)
    measure("neighbours, scikit-learn: index", "point", len(points), lambda: model.fit(points, classes))
    voted = measure("neighbours, scikit-learn", "query", len(queries), lambda: model.predict(queries))
    tell("neighbours, scikit-learn: same class as ours", "share", np.mean(voted == ours))


main()
