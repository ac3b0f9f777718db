# Thin wrappers: the packages, CMake's presets, and `wobble play`.
FOR ?= 0

PART ?=

BESIDE ?=

.PHONY: play test sanitized built races nightly lab image format
play:
	@sh docker/packages.sh server web
	@cmake --preset release --log-level=WARNING
	@cmake --build --preset release --target programs
	@build/release/bin/wobble play --for $(FOR)

# What only computes runs side by side, so that no core waits for the last file or test of a part; the released tests,
# some of which measure times, follow alone. BESIDE: targets that are to run with them.
test:
	@sh docker/packages.sh server web test python lab
	@CMAKE_BUILD_PARALLEL_LEVEL="$$(nproc)" $(MAKE) --no-print-directory --jobs=3 --output-sync=target sanitized built $(BESIDE)
	@ctest --preset release
	@python3 tests/slowest.py build/asan build/release

sanitized:
	@cmake --workflow --preset asan

built:
	@cmake --preset release
	@cmake --build --preset release

races:
	@cmake --preset tsan
	@cmake --build --preset tsan
	@ctest --preset tsan -R threads_test

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
