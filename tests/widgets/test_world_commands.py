"""What a page does to the world of the simulated robot."""

import json

import pytest

from lrp_jupyter.sim import load
from lrp_jupyter.sim.worlds import BUNDLED

IDLE = "(machine m (state a)) (spawn m a)"


@pytest.fixture
def lab(bench):
    return bench(IDLE, bridge="sim", world="empty")


@pytest.fixture
def page(lab):
    page = lab.page()
    lab.publish()
    return page


def world(page):
    return page.last("world")["world"]


def test_a_wall_is_put_changed_and_removed(lab, page):
    assert page.do("put_solid", box=[1.0, 0.5, 0.4, 0.05], angle=0.5, name="wall") is None
    assert world(page)["solids"] == [{"box": [1.0, 0.5, 0.4, 0.05], "angle": 0.5, "name": "wall"}]
    assert page.do("put_solid", index=0, circle=[1.0, 0.5, 0.2], push=0.3) is None
    lab.publish()
    assert lab.session.bridge.world.solids[0].circle == (1.0, 0.5, 0.2)
    assert page.do("remove_solid", index=0) is None
    assert lab.session.bridge.world.solids == ()
    assert "no solid 0" in page.do("remove_solid", index=0)
    assert "Expected one of `box` or `circle`, not none" in page.do("put_solid")
    assert "`solid.box[2]`" in page.do("put_solid", box=[1, 1, 0, 1])


def test_what_moves_by_itself_is_in_every_frame_and_keeps_its_patrol_when_it_is_edited(lab, page):
    page.do("world", name="crossing")
    page.do("step", value=10)
    cart, _ = world(page)["solids"]
    assert cart["patrol"] == [[1.2, 0.2], [1.2, pytest.approx(1.3)]]
    lab.publish()
    assert lab.session.frame.robot.solids[0] == pytest.approx((1.2, 0.4, 0.0))
    assert page.do("put_solid", index=0, box=[1.5, 0.5, 0.3, 0.3], name="lorry") is None
    lorry = lab.session.bridge.simulation.solids[0]
    assert lorry.pose == pytest.approx((1.5, 0.5, 0))
    page.do("step", value=5)
    assert lorry.pose == pytest.approx((1.5, 0.6, 0))
    assert page.do("put_solid", index=0, box=[1.5, 0.5, 0.3, 0.3], push=0.3) is None
    assert lab.session.bridge.world.solids[0].patrol is None


def test_a_changed_world_is_described_before_the_reply_however_soon_and_busy_the_view(lab):
    page = lab.page(pays=False)
    for _ in range(20):
        lab.session.step()
        lab.publish()  # no more frames may be sent until the view has acknowledged some
    for x in (1.0, 1.1):
        lab.wall.now -= 0.5  # the whole round takes no time
        assert page.do("put_solid", index=0 if x > 1 else None, box=[x, 0.5, 0.4, 0.05]) is None
        described, reply = page.messages[-2:]
        assert described["world"]["solids"][0]["box"][0] == x
        assert reply["type"] == "reply"


def test_zones_and_the_start_are_put_and_kept_over_a_reset_of_the_world(lab, page):
    assert page.do("put_zone", name="goal", circle=[2.0, 1.0, 0.3]) is None
    assert page.do("put_zone", name="end", former="goal", box=[2.0, 1.0, 0.3, 0.2]) is None
    assert page.do("set_start", index=0, pose=[0.5, 0.6, 1.0]) is None
    page.do("reset_world")
    assert list(lab.session.bridge.world.zones) == ["end"]
    assert lab.session.frame.robot.robots[0].pose == pytest.approx((0.5, 0.6, 1.0))
    assert page.do("remove_zone", name="end") is None
    page.do("reset_world", drawings=True)
    assert lab.session.bridge.world == load("empty")


def test_every_edit_can_be_undone_and_redone_also_the_choice_of_another_world(lab, page):
    assert "no edit of the world that could be undone" in page.do("undo_world")
    page.do("stroke", points=[[0.2, 0.2], [0.4, 0.2]], width=0.03, grey=0)
    page.do("put_solid", box=[1.0, 0.5, 0.4, 0.05])
    edited = lab.session.bridge.world
    page.do("world", name="maze")
    assert page.do("undo_world") is None
    assert lab.session.bridge.world == edited
    assert page.do("undo_world") is None
    assert lab.session.bridge.world.solids == ()
    assert page.do("undo_world") is None
    assert lab.session.bridge.world == load("empty")
    for _ in range(2):
        assert page.do("redo_world") is None
    assert lab.session.bridge.world == edited
    page.do("erase", points=[[0.2, 0.2]], width=0.1)
    assert "could be redone" in page.do("redo_world")


def test_a_view_knows_whether_there_is_something_to_undo(lab, page):
    def flags():
        lab.publish()
        return [world(page)[name] for name in ("edited", "undo", "redo")]

    page.do("put_solid", box=[1.0, 0.5, 0.4, 0.05])
    assert flags() == [True, True, False]
    page.do("undo_world")
    assert flags() == [False, False, True]


def test_what_is_placed_stays_when_the_program_is_stepped_back(lab, page):
    page.do("step", value=3)
    page.do("put_solid", box=[1.0, 0.5, 0.4, 0.05])
    page.do("step", value=2)
    assert page.do("step_back", value=4) is None
    assert len(lab.session.bridge.world.solids) == 1
    assert page.do("undo_world") is None
    assert lab.session.bridge.world.solids == ()


def test_a_world_is_saved_as_json_and_loaded_again(lab, page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page.do("put_solid", box=[1.0, 0.5, 0.4, 0.05], name="wall")
    page.do("stroke", points=[[0.2, 0.2], [0.4, 0.2]], width=0.03, grey=0)
    assert page.ask("save_world", name="mine", replace=False)["exists"] is False
    assert page.ask("save_world", name="mine", replace=False)["exists"] is True
    assert page.ask("worlds")["worlds"] == [*BUNDLED, "mine.world.json"]
    saved = json.loads((tmp_path / "mine.world.json").read_text())
    assert saved["name"] == "mine"
    edited = lab.session.bridge.world
    page.do("world", name="maze")
    assert page.do("world", name="mine.world.json") is None
    assert lab.session.bridge.world.solids == edited.solids
    assert lab.session.bridge.world.floor == edited.floor
    assert "mine.world.json" in lab.page("another").last("snapshot")["choices"]["worlds"]
    saved["name"] = "yours"
    assert page.do("world_text", text=json.dumps(saved)) is None
    assert lab.session.bridge.world.name == "yours"
    assert "The file is not valid JSON: line 1" in page.do("world_text", text="{")
    assert "The file: `size[0]`" in page.do("world_text", text='{"version": 1, "size": [0, 1], "robots": []}')


def test_a_picture_shows_the_world_as_it_is(lab, page):
    page.do("put_zone", name="harbour", circle=[2.0, 1.0, 0.3])
    assert ">harbour</text>" in page.ask("world_picture")["svg"]


@pytest.mark.parametrize("name", ["", " ", ".", "/"])
def test_a_world_is_not_saved_without_a_name(page, name):
    assert page.ask("save_world", name=name, replace=True)["error"] == "Enter a name for the file."


def test_a_moving_picture_shows_the_remembered_run(lab, page):
    page.do("put_zone", name="harbour", circle=[2.0, 1.0, 0.3])
    page.do("step", value=20)
    picture = page.ask("world_animation")["svg"]
    assert ">harbour</text>" in picture
    assert "0.0 to 2.0 s" in picture
    page.do("world", name="maze")
    page.do("step", value=10)
    assert "maze · 0.0 to 1.0 s" in page.ask("world_animation")["svg"]
