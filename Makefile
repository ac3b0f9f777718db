# Thin wrappers: the packages, CMake's presets, and `wobble play`.
FOR ?= 0

PART ?=

.PHONY: play test nightly lab image format
play:
	@sh docker/packages.sh server web
	@cmake --preset release --log-level=WARNING
	@cmake --build --preset release --target programs
	@build/release/bin/wobble play --for $(FOR)

test:
	@sh docker/packages.sh server web test python lab
	@rm -f build/asan/Testing/tests.xml build/release/Testing/tests.xml
	@cmake --workflow --preset asan || python3 tests/failed.py build/asan
	@cmake --workflow --preset release || python3 tests/failed.py build/release
	@python3 tests/slowest.py build/asan build/release

nightly:
	@python3 tests/nightly.py $(PART)

lab:
	@sh docker/packages.sh server test lab
	@cmake --preset release --log-level=WARNING
	@cmake --build --preset release --target wobble_lab
	@build/release/bin/wobble_lab all --into tests/bench/results

image:
	@sh docker/build_image.sh

format:
	@sh docker/packages.sh server test
	@cmake --preset dev --log-level=WARNING
	@cmake --build --preset dev --target format
