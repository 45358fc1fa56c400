# Everyday commands of a developer; users need none of them.
PYTHON ?= python
BUILD ?= build/dev
HTML ?= docs/_build/html
# one instruction set (AVX2) compiles in a third of the time; ON makes those that wheels have
PORTABLE ?= OFF

.PHONY: core test campaign lint docs
core:  ## build the extension module in place
	cmake -S . -B $(BUILD) -G Ninja -DCMAKE_COMPILE_WARNING_AS_ERROR=ON -DVISVIVA_PORTABLE=$(PORTABLE) -DPython_EXECUTABLE=$$($(PYTHON) -c 'import sys; print(sys.executable)') >/dev/null
	cmake --build $(BUILD)
	cmake --install $(BUILD) --component python --prefix src >/dev/null
test: core
	PYTHONPATH=src $(PYTHON) -m pytest
campaign: core  ## what takes longer than a test may; short forms of it are among the tests
	cd tests && PYTHONPATH=../src $(PYTHON) -m campaign && PYTHONPATH=../src $(PYTHON) -m verified
lint:
	ruff check . && ruff format --check . && mypy
	check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml
	check-jsonschema --builtin-schema vendor.github-issue-forms .github/ISSUE_TEMPLATE/[!c]*.yml
	check-jsonschema --builtin-schema vendor.github-issue-config .github/ISSUE_TEMPLATE/config.yml
	check-jsonschema --builtin-schema vendor.citation-file-format CITATION.cff
	clang-format --dry-run --Werror $$(git ls-files 'cpp/*.cpp' 'cpp/*.hpp')
docs:  ## of the package that is installed, or of what `make core` has built in place
	PYTHONPATH=$(if $(wildcard src/visviva/_core.*.so),$(CURDIR)/src) sphinx-build -W -b html docs $(HTML)
