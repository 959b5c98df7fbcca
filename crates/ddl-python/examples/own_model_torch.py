"""A small torch model, trained and evaluated on the folds of the benchmark.

pip install ddl-forecast torch
python own_model_torch.py [simulated|star] [EPOCHS]
"""

import sys

import numpy as np
import torch
from ddl_forecast import evaluate, windows
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def trained(convention: str, fold: str, epochs: int) -> torch.nn.Module:
    """A perceptron from the observed steps to the 12 positions, relative to the last one."""
    training = windows(convention, fold=fold, part="training")
    past = torch.tensor(np.concatenate([window.past for window in training]), dtype=torch.float32)
    future = torch.tensor(np.concatenate([window.future for window in training]), dtype=torch.float32) - past[:, -1:]
    torch.manual_seed(0)
    net = torch.nn.Sequential(torch.nn.Flatten(), torch.nn.Linear(14, 128), torch.nn.ReLU(), torch.nn.Linear(128, 24))
    optimizer = torch.optim.Adam(net.parameters(), lr=1e-3)
    for _ in range(epochs):
        for batch in torch.randperm(len(past)).split(256):
            loss = (net(past[batch].diff(dim=1)).reshape(-1, 12, 2) - future[batch]).norm(dim=-1).mean()
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
    return net


class Forecaster:
    """The function that `evaluate` calls with the observed positions, without the future."""

    def __init__(self, net: torch.nn.Module) -> None:
        self.net = net

    def __call__(self, past: Floats) -> Floats:
        with torch.no_grad():
            ahead = self.net(torch.tensor(np.diff(past, axis=1), dtype=torch.float32)).reshape(-1, 12, 2)
        path: Floats = past[:, -1:] + ahead.double().numpy()
        return path


if __name__ == "__main__":
    convention = sys.argv[1] if len(sys.argv) > 1 else "simulated"
    epochs = int(sys.argv[2]) if len(sys.argv) > 2 else 10
    folds = ["eth", "hotel", "univ", "zara1", "zara2"] if convention == "star" else ["plaza", "crossing"]
    models = {fold: Forecaster(trained(convention, fold, epochs)) for fold in folds}
    results = evaluate(models, convention=convention, name="perceptron")
    print(results.to_markdown("A perceptron"))
    print(f"mean ADE/FDE {results.mean('min_ade'):.3f}/{results.mean('min_fde'):.3f} m")
