"""The functions of FMI 3.0 in a module of WebAssembly: played as the native binary is, and refused with its words."""

import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from gearheat.fmu.compiling import platforms
from gearheat.fmu.export import export
from gearheat.fmu.play import Player
from gearheat.model.errors import FmuError

#: Ramps and jumps of speed and load.
DUTY = {
    "governor.w": (np.array([0.0, 600, 1200, 1200, 1800]), np.array([150.0, 150, 210, 120, 120])),
    "load.tau": (np.array([0.0, 900, 900, 1800]), np.array([20.0, 30, 60, 60])),
}
#: Where the C libraries' functions differ in the last digit.
SAME = 1e-9


@pytest.fixture(scope="module")
def web_fmu(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(models.heat, tmp_path_factory.mktemp("web") / "web.fmu", platform="wasm32", fmi=3)


def test_the_module_gives_what_the_native_binary_gives(web_fmu: Path, heat_fmu_3: Path) -> None:
    pytest.importorskip("wasmtime", reason="wasmtime runs the module: pip install wasmtime")
    with Player(web_fmu) as web, Player(heat_fmu_3) as native:
        assert web.described.web and not native.described.web
        for start in ({}, {"shaft.w": 120.0}, {}):
            one, other = (player.run(DUTY, 1800.0, 60.0, start=start) for player in (web, native))
            kept = [k for k, name in enumerate(other.names) if not name.endswith("residual")]
            np.testing.assert_allclose(one.values[:, kept], other.values[:, kept], rtol=SAME, atol=SAME)
        said = []
        for player in (web, native):
            with pytest.raises(FmuError) as error:
                player.run(DUTY, 1800.0, 60.0, start={"oil.T": -5.0})
            said.append(str(error.value).partition(":")[2])
        assert said[0] == said[1] and "out of range" in said[0]


def test_what_the_module_needs_is_said(web_fmu: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with zipfile.ZipFile(web_fmu) as file:
        assert [n for n in file.namelist() if n.startswith("binaries/")] == [
            "binaries/wasm32-wasip1/shaft_and_heat.wasm"
        ]
        with zipfile.ZipFile(tmp_path / "damaged.fmu", "w") as other:
            for name in file.namelist():
                other.writestr(name, file.read(name)[:2000] if name.endswith(".wasm") else file.read(name))
    with pytest.raises(FmuError, match=r"damaged.fmu cannot be loaded: (.|\n)*end-of-file"):
        Player(tmp_path / "damaged.fmu")
    monkeypatch.setattr("gearheat.fmu.web_slave.find_spec", lambda name: None)
    with pytest.raises(FmuError, match=r'web.fmu cannot be loaded: .* pip install "gearheat\[wasm\]"'):
        Player(web_fmu)
    with pytest.raises(FmuError, match=r'"wasm32" is one of FMI 3\.0\. Add --fmi 3'):
        platforms("wasm32")
    assert not any("wasm" in platform.name for platform in platforms("all", 3))
