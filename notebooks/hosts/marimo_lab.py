# A lab in marimo: `marimo edit marimo_lab.py`. Cells depend on the robot, its blocks on what cells define.
import marimo

app = marimo.App(width="full")


@app.cell
def _():
    import marimo as mo

    import lrp_jupyter

    return lrp_jupyter, mo


@app.cell
def _(mo):
    pace = mo.ui.slider(0.05, 0.3, 0.05, value=0.2, label="Pace in m/s")
    pace
    return (pace,)


@app.cell
def _(lrp_jupyter, mo):
    # `program` is for what stays: the cell below that shows its graph runs once
    program = lrp_jupyter.Lab(
        """
        (var speed := [0.0])

        (machine driver
          (event black [robot.light.data < 118])
          (event white [robot.light.data > 138])

          (state left (running [
            speed = pace.value
            robot.move(linear=speed, angular=1.5)]))
          (state right (running [
            speed = pace.value
            robot.move(linear=speed, angular=-1.5)]))

          (on black left -> right)
          (on white right -> left))

        (spawn driver left)
        """,
        namespace=globals(),  # blocks read the names of the notebook
    )
    # `lab` is for what changes: cells that use it run again when the robot changes its state
    lab = mo.ui.anywidget(program)
    lab
    return lab, program


@app.cell
def _(lab, mo):
    mo.md(" and ".join("/".join(path) for path in lab.frame.active) + f" at {lab.frame.time:.0f} s")
    return


@app.cell
def _(lrp_jupyter, program):
    lrp_jupyter.StateGraph(program)
    return


if __name__ == "__main__":
    app.run()
