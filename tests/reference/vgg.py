# tests/reference/vgg.py -- a small network of VGG's kind, and the Gram loss under masks, in PyTorch
# SPDX-License-Identifier: Apache-2.0
"""Layers, and derivatives by the image, in double. The weights are random (inputs.py), their names torchvision's."""
import numpy as np
import torch
import inputs

CHANNELS = [3, 6, 7, 8, 9, 10]
WIDTH, HEIGHT = 21, 14
MEAN, DEVIATION = [0.485, 0.456, 0.406], [0.229, 0.224, 0.225]


def network(pooling):
    """Convolutions 0, 2 | 5, 7 | 10 of torch.nn.Sequential, and the places of the layers that are asked for."""
    steps = []
    for k in range(5):
        if k in (2, 4):
            steps.append(torch.nn.MaxPool2d(2, 2) if pooling == "max" else torch.nn.AvgPool2d(2, 2))
        steps += [torch.nn.Conv2d(CHANNELS[k], CHANNELS[k + 1], 3, padding=1), torch.nn.ReLU()]
    features = torch.nn.Sequential(*steps).double()
    weights = {}
    for k, number in enumerate((0, 2, 5, 7, 10)):
        n, a = CHANNELS[k + 1] * CHANNELS[k] * 9, np.sqrt(6 / (9 * CHANNELS[k]))
        shape = (CHANNELS[k + 1], CHANNELS[k], 3, 3)
        weights[f"{number}.weight"] = torch.tensor(inputs.between(30 + k, n, 0, -a, a).reshape(shape))
        weights[f"{number}.bias"] = torch.tensor(inputs.between(30 + k, CHANNELS[k + 1], 1, -0.1, 0.3))
    features.load_state_dict(weights)
    return features, (1, 6, 11)


def picture(stream):
    pixels = [inputs.between(stream, WIDTH * HEIGHT, c, 0, 1) for c in range(3)]
    return torch.tensor(np.stack(pixels).reshape(3, HEIGHT, WIDTH)).double()


def mask(stream):
    """0, 1/4, ... 1; the left third, or for an odd stream the right one, is out."""
    m = np.floor(inputs.uniform(stream, WIDTH * HEIGHT, 0) * 5).reshape(HEIGHT, WIDTH) / 4
    x = np.arange(WIDTH)
    return torch.tensor(m * (x >= WIDTH // 3 if stream % 2 == 0 else x < 2 * WIDTH // 3)[None])


def layers(features, places, image):
    normal = lambda v: torch.tensor(v).double().reshape(3, 1, 1)
    x, out = ((image - normal(MEAN)) / normal(DEVIATION))[None], []
    for k, step in enumerate(features):
        x = step(x)
        if k in places:
            out.append(x[0])
    return out


def grams(features, places, image, m):
    """The part over its mean; each layer's Gram matrix under the mask, averaged where the network pools."""
    mean = (image * m).sum((1, 2), keepdim=True) / m.sum()
    out, w = [], m[None, None]
    for f in layers(features, places, image * m + mean * (1 - m)):
        while w.shape[-1] > f.shape[-1]:
            w = torch.nn.functional.avg_pool2d(w, 2, 2)
        out.append(torch.einsum("yx,iyx,jyx->ij", w[0, 0], f, f) / w.sum())
    return out


def gram_loss(theirs, ours):
    loss = 0
    for g, h in zip(theirs, ours):
        square = torch.diagonal(g)
        unit = torch.sqrt(square + 0.01 * square.mean())
        loss = loss + ((h - g) / torch.outer(unit, unit)).abs().mean() / len(theirs)
    return loss


def arrays():
    out = {}
    for pooling in ("max", "average"):
        features, places = network(pooling)
        image = picture(36).requires_grad_()
        made = layers(features, places, image)
        value = 0
        for k, layer in enumerate(made):
            out[f"vgg_{pooling}_layer{k}"] = (layer.detach().numpy().astype(np.float32), 1e-6)
            by = inputs.between(40 + k, layer.numel(), 0, -1, 1).reshape(layer.shape)
            value = value + (layer * torch.tensor(by)).sum()
        value.backward()
        out[f"vgg_{pooling}_by_image"] = (image.grad.numpy().astype(np.float32), 1e-6)

        image = picture(36).requires_grad_()
        photo = [g.detach() for g in grams(features, places, picture(37), mask(38))]
        loss = gram_loss(photo, grams(features, places, image, mask(39)))
        loss.backward()
        out[f"vgg_{pooling}_gram_loss"] = (loss.detach().numpy().astype(np.float32).reshape(1), 1e-6)
        out[f"vgg_{pooling}_gram_by_image"] = (image.grad.numpy().astype(np.float32), 1e-6)
    return out
