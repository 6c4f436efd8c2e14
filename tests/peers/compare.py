"""Runs the peers beside ours: the same input, one run after the other, medians of the pairs.

    python3 -m venv venv && venv/bin/pip install -r tests/peers/requirements.txt
    cargo build --release -p reprise-evaluate --example peer
    venv/bin/python tests/peers/compare.py target/release/examples/peer actor.reprise [--rounds 5] [--only dtw,paths]

Prints a table in Markdown. Each comparison also checks that both sides found the same, where they solve the same problem.
"""

import argparse
import importlib.metadata
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np


class Row:
    """One line of the table: seconds of paired runs, and how to read them."""

    def __init__(self, what, peer, unit, work, check):
        self.what, self.peer, self.unit, self.work, self.check = what, peer, unit, work, check
        self.ours, self.theirs = [], []

    def line(self):
        ours, theirs = statistics.median(self.ours), statistics.median(self.theirs)
        ratio = statistics.median(t / o for o, t in zip(self.ours, self.theirs))
        show = lambda seconds: f"{self.work / seconds:,.4g} {self.unit}" if self.work else f"{seconds * 1e3:,.1f} ms"
        return f"| {self.what} | {show(ours)} | {self.peer} | {show(theirs)} | {ratio:.2f} | {self.check} |"


def ours(program, *arguments):
    """Seconds of our example, as it measures them itself: without reading and writing files."""
    words = [str(program), *map(str, arguments)]
    return float(subprocess.run(words, check=True, capture_output=True, text=True).stdout)


def timed(work):
    start = time.perf_counter()
    result = work()
    return result, time.perf_counter() - start


def version(package):
    return f"{package} {importlib.metadata.version(package)}"


def dtw(program, folder, rounds, _bundle):
    """All windows of a series against each other, no slope limit, |a - b|."""
    from dtaidistance import dtw as peer

    random = np.random.default_rng(1)
    length, n = 50, 400
    series = np.cumsum(random.normal(size=n)).astype(np.float32)
    np.save(folder / "series.npy", series)
    windows = n + 1 - length
    double = series.astype(np.double)
    cut = [np.ascontiguousarray(double[i : i + length]) for i in range(windows)]
    cells = windows * windows * length * length
    chosen = random.integers(0, windows, size=(4000, 2))
    row = Row("DTW, cells a second, one thread each", version("dtaidistance"), "cell/s", cells, "")
    for _ in range(rounds):
        row.ours.append(ours(program, "dtw", folder / "series.npy", length, folder / "dtw.npy"))
        found, seconds = timed(lambda: [peer.distance_fast(cut[i], cut[j], inner_dist="euclidean") for i, j in chosen])
        row.theirs.append(seconds * windows * windows / len(chosen))
    own = np.load(folder / "dtw.npy")[chosen[:, 0], chosen[:, 1]]
    row.check = f"sums differ by {np.abs(own - np.array(found)).max():.1e} at most"
    return [row]


def paths(program, folder, rounds, _bundle):
    """A dense digraph of 1,000 nodes; ours finds the essential edges too."""
    import rustworkx
    from scipy.sparse.csgraph import floyd_warshall

    n = 1000
    costs = (np.random.default_rng(2).integers(1, 1 << 20, size=(n, n)) / (1 << 18)).astype(np.float32)
    np.fill_diagonal(costs, np.inf)
    np.save(folder / "costs.npy", costs)
    dense = costs.astype(np.double)
    graph = rustworkx.PyDiGraph()
    graph.add_nodes_from(range(n))
    graph.add_edges_from([(i, j, dense[i, j]) for i in range(n) for j in range(n) if i != j])
    rows = [
        Row("All shortest paths and essential edges, 1,000 nodes", version("scipy"), None, None, ""),
        Row("the same", version("rustworkx"), None, None, ""),
    ]
    for _ in range(rounds):
        for row, work in zip(
            rows,
            [lambda: floyd_warshall(dense), lambda: rustworkx.digraph_floyd_warshall_numpy(graph, float)],
        ):
            row.ours.append(ours(program, "paths", folder / "costs.npy", folder / "edges.npy"))
            found, seconds = timed(work)
            row.theirs.append(seconds)
            edges = np.load(folder / "edges.npy")
            # An edge is kept if and only if it is the shortest path of its ends; with random costs there are no ties.
            shortest = np.asarray(found)
            expected = {(i, j) for i, j in zip(*np.nonzero(shortest == dense)) if i != j}
            same = expected == {tuple(edge) for edge in edges.tolist()}
            row.check = f"{len(edges)} edges, {'the same' if same else 'NOT the same'}"
    return rows


def between(program, folder, rounds, bundle):
    """In-betweens of two frames: ours by Poisson, libigl's as rigid as possible, ten iterations each."""
    import igl

    ours(program, "export", bundle, folder)
    poses, faces = np.load(folder / "poses.npy"), np.load(folder / "faces.npy").astype(np.int64)
    i, j = 0, len(poses) // 2
    a, b = poses[i].astype(np.double), poses[j].astype(np.double)
    count = 20
    row = Row(
        f"In-betweens, {len(a):,} vertices, one thread", version("libigl") + ", ARAP, 10 iterations", "a second", count, ""
    )
    fixed = np.array([0], dtype=np.int32)
    for _ in range(rounds):
        row.ours.append(
            ours(program, "between", folder / "poses.npy", folder / "faces.npy", i, j, count, folder / "between.npy")
        )
        data = igl.ARAPData()
        data.max_iter = 10
        igl.arap_precomputation(np.asfortranarray(a), np.asfortranarray(faces), 3, fixed, data)

        def work():
            for k in range(count):
                blend = np.asfortranarray(a + (b - a) * (k + 1) / (count + 1))
                igl.arap_solve(blend[fixed], data, blend)

        row.theirs.append(timed(work)[1])
    row.check = "other problems: time only"
    return [row]


def sequence(program, folder, rounds, bundle):
    """Positions of all frames: size and decoding time. Peers code each frame by itself at the same error bound."""
    import DracoPy
    import meshoptimizer

    ours(program, "export", bundle, folder)
    poses, faces = np.load(folder / "poses.npy"), np.load(folder / "faces.npy")
    frames = poses[:: max(1, len(poses) // 60)]
    # The same bound of 0.5 mm on the distance: a step of 2 * 0.5 / sqrt(3) mm on each axis.
    step = 2 * 0.5e-3 / np.sqrt(3)
    low = poses.min(axis=(0, 1))
    extent = float((poses.max(axis=(0, 1)) - low).max())
    bits = int(np.ceil(np.log2(extent / step)))

    quantised = [np.zeros((poses.shape[1], 4), dtype=np.uint16) for _ in frames]
    for out, pose in zip(quantised, frames):
        out[:, :3] = np.round((pose - low) / step)
    coded = [meshoptimizer.encode_vertex_buffer(q, len(q), 8) for q in quantised]
    draco = [
        DracoPy.encode(
            pose,
            faces,
            quantization_bits=bits,
            quantization_range=step * (2**bits - 1),
            quantization_origin=low,
            compression_level=7,
            preserve_order=True,
        )
        for pose in frames
    ]
    rows = [
        Row("Decoding a frame", version("meshoptimizer"), None, None, ""),
        Row("the same", version("DracoPy") + ", with its connectivity", None, None, ""),
    ]

    def meshopt():
        for data in coded:
            meshoptimizer.decode_vertex_buffer(poses.shape[1], 8, data)

    for _ in range(rounds):
        for row, work in zip(rows, [meshopt, lambda: [DracoPy.decode(data) for data in draco]]):
            row.ours.append(ours(program, "decode", bundle) / len(poses))
            row.theirs.append(timed(work)[1] / len(frames))
    rows[0].check = f"{np.mean([len(data) for data in coded]) / 1e3:.1f} KB a frame"
    rows[1].check = f"{np.mean([len(data) for data in draco]) / 1e3:.1f} KB a frame, connectivity in each"
    return rows


def pca(program, folder, rounds, _bundle):
    """50 components of 300 textures of 256 x 256, a few smooth patterns and noise."""
    from sklearn.decomposition import PCA

    random = np.random.default_rng(3)
    n, columns, count = 300, 3 * 256 * 256, 50
    patterns = random.normal(size=(60, columns)).astype(np.float32)
    weights = random.normal(size=(n, 60)).astype(np.float32) * (0.02 * 0.93 ** np.arange(60, dtype=np.float32))
    rows = weights @ patterns
    rows += 0.5 + 0.002 * random.normal(size=rows.shape).astype(np.float32)
    np.save(folder / "rows.npy", rows)
    row = Row("50 components of 300 textures of 256 x 256", version("scikit-learn"), None, None, "")
    for _ in range(rounds):
        row.ours.append(ours(program, "pca", folder / "rows.npy", count, folder / "variances.npy"))
        found, seconds = timed(lambda: PCA(n_components=count, random_state=1).fit(rows))
        row.theirs.append(seconds)
    # Theirs divide by one less than the number of rows.
    expected = found.explained_variance_ * (n - 1) / n
    row.check = f"variances differ by {np.abs(np.load(folder / 'variances.npy') / expected - 1).max():.1e} at most"
    return [row]


def flow(program, folder, rounds, _bundle):
    """Two textures of 1024 x 1024, one bent by a known warp, a little brighter and with noise."""
    import cv2

    size = 1024
    random = np.random.default_rng(4)
    y, x = np.mgrid[0:size, 0:size].astype(np.float32)
    base = sum(
        cv2.GaussianBlur(random.normal(size=(size, size)).astype(np.float32), (0, 0), sigma) * sigma
        for sigma in (1.5, 4.0, 12.0)
    )
    base = (base - base.min()) / (base.max() - base.min())
    truth = np.stack([4 * np.sin(0.02 * y + 0.007 * x), 4 * np.cos(0.017 * x - 0.009 * y)], axis=-1)
    a = cv2.remap(base, x + truth[..., 0], y + truth[..., 1], cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)
    b = base * 1.05 + 0.01 * random.normal(size=base.shape)
    textures = [np.clip(np.round(t * 255), 0, 255).astype(np.uint8) for t in (a, b)]
    for name, texture in zip("ab", textures):
        np.save(folder / f"{name}.npy", texture.astype(np.float32) / 255)
    row = Row("Flow of two textures of 1024 x 1024", f"OpenCV {cv2.__version__}, DIS medium", None, None, "")
    peer = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    for _ in range(rounds):
        row.ours.append(ours(program, "flow", folder / "a.npy", folder / "b.npy", folder / "flow.npy"))
        found, seconds = timed(lambda: peer.calc(*textures, None))
        row.theirs.append(seconds)
    error = lambda flow: np.hypot(*(flow - truth)[16:-16, 16:-16].reshape(-1, 2).T).mean()
    row.check = f"end-point error {error(np.load(folder / 'flow.npy')):.3f} against {error(found):.3f} texels"
    return [row]


COMPARISONS = {"dtw": dtw, "paths": paths, "between": between, "sequence": sequence, "pca": pca, "flow": flow}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("bundle", type=pathlib.Path)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only", default=",".join(COMPARISONS))
    arguments = parser.parse_args()
    print("| what | ours | peer | theirs | theirs / ours | check |\n|---|---|---|---|---|---|")
    failed = False
    for name in arguments.only.split(","):
        with tempfile.TemporaryDirectory() as folder:
            try:
                rows = COMPARISONS[name](arguments.program, pathlib.Path(folder), arguments.rounds, arguments.bundle)
            except ImportError as error:
                print(f"| {name} | | missing: {error} | | | |")
                failed = True
                continue
        for row in rows:
            print(row.line(), flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
