#!/usr/bin/env bash
# Tests wobble_lab from its command line: refusals, written files, and that the quick run of a report keeps its limits.
#
#   bash lab_test.sh CASE BIN_DIR
#
# Exit code 0: the case holds; 1: it does not, and the expectation and the actual output are printed.
set -uo pipefail

readonly case_name="${1:?usage: lab_test.sh CASE BIN_DIR}"
lab="$(cd "${2:?usage: lab_test.sh CASE BIN_DIR}" && pwd)/wobble_lab" || exit 1
readonly lab
folder="$(mktemp -d)" || exit 1
readonly folder
readonly out="$folder/out" err="$folder/err"
trap 'rm -rf "$folder"' EXIT
export XDG_STATE_HOME="$folder/state" # where the servers that it starts keep their key
unset STATE_DIRECTORY

fail() {
  echo "FAILED $case_name: expected $1; came:"
  sed 's|^|  out: |' "$out"
  sed 's|^|  err: |' "$err"
  exit 1
}

# expect_exit CODE ARGUMENT...
expect_exit() {
  local code
  PATH="${lab_path-$PATH}" "$lab" "${@:2}" >"$out" 2>"$err"
  code=$?
  [ "$code" -eq "$1" ] || fail "exit code $1 of wobble_lab ${*:2}, not $code"
}

expect_line() { # FILE PATTERN
  grep -q -e "$2" "$1" || fail "a line '$2'"
}

# Expects one line on standard error and no files left behind.
expect_refusal() { # PATTERN ARGUMENT...
  expect_exit 2 "${@:2}"
  expect_line "$err" "$1"
  [ "$(wc -l <"$err")" -eq 1 ] || fail "one line"
}

case_help_and_version() {
  local words
  for words in '' accuracy capacity codec contact interpolation link skip stability throughput; do
    # shellcheck disable=SC2086  # no word at all when there is no report
    expect_exit 0 $words --help
    expect_line "$out" '^Examples:'
    expect_line "$out" "^  wobble_lab ${words:-accuracy} --quick\$"
    # shellcheck disable=SC2086
    expect_exit 0 $words --version
    expect_line "$out" '^wobble_lab [0-9][0-9]*\.[0-9][0-9]*\.[0-9][0-9]*$'
  done
}

case_bad_use() {
  expect_refusal 'a report is required, one of: accuracy, stability, contact, throughput, skip, codec, interpolation, link, capacity, or all'
  expect_refusal 'not expected: gravity' gravity
  expect_refusal 'not expected: --loud' contact --loud
  expect_refusal "'-1' is not 0 to 9007199254740992" contact --seed=-1
  expect_refusal "'x' is not 0 to" contact --trial x
  expect_refusal "^wobble_lab: --json: $folder/none/a.json cannot be written" contact --json "$folder/none/a.json"
  touch "$folder/file"
  expect_refusal "^wobble_lab: --plot: $folder/file/plots: " contact --plot "$folder/file/plots"
  expect_refusal "^wobble_lab: --into: $folder/file/" all --into "$folder/file"
  expect_refusal 'not expected: 1 --trial' accuracy --trial 1
  expect_refusal "not expected: arena --scene" codec --scene arena
  expect_refusal "^wobble_lab: --scene: scene 'nowhere' is not known" capacity --scene nowhere
  expect_refusal '^wobble_lab: --script: .*nowhere.lua' capacity --script nowhere
  expect_refusal "'0' is not 1 to 2000" capacity --players 0
  expect_refusal "^wobble_lab: --part: no part with 'nothing' in its name, there are: links, budget" interpolation --part nothing
  cp "$lab" "$folder/alone"
  "$folder/alone" throughput --part crowds >"$out" 2>"$err"
  [ $? -eq 2 ] || fail 'exit code 2 where the shipped scenes are not'
  expect_line "$err" "^wobble_lab: the shipped scenes are neither in a folder 'scenes' beside this program nor"
  lab_path=/nowhere expect_refusal '^wobble_lab: --plot: gnuplot is not installed' contact --plot "$folder/plots"
}

case_interrupt() {
  "$lab" contact --json "$folder/a.json" >"$out" 2>"$err" &
  local pid=$!
  sleep 0.5
  kill -INT "$pid"
  wait "$pid"
  [ $? -eq 1 ] || fail "exit code 1"
  expect_line "$err" '^wobble_lab: stopped before it was done: no results$'
  [ ! -e "$folder/a.json" ] || fail "no results"
}

# expect_recording JSON: what the latest output names is a recording, which is in this file, and plays the same again.
expect_recording() {
  local file
  file="$(sed -n 's/^.*; wobble watch \(.*wobrec\)$/\1/p' "$out" | head -n 1)"
  grep -q 'it differs\|not recorded' "$out" && fail 'the trials to the bit'
  expect_line "$1" "\"recording\": \"$file\""
  "${lab%/*}/wobbled" --replay "$file" --verify >"$out" 2>"$err" || fail "that $file plays the same"
  expect_line "$out" '^identical: [1-9][0-9]* ticks'
}

# A trial by its number is there to be watched.
case_recorded_trial() {
  expect_exit 0 stability --trial 12 --recordings "$folder/recordings" --json "$folder/a.json"
  expect_recording "$folder/a.json"
  expect_exit 0 stability --trial 36 --recordings "$folder/recordings" --json "$folder/a.json"
  expect_recording "$folder/a.json"
  expect_exit 0 capacity --quick --players 2 --recordings "$folder/recordings" --json "$folder/a.json"
  "${lab%/*}/wobbled" --replay "$folder/recordings/worst-of-2.wobrec" --verify >"$out" 2>"$err" ||
    fail 'that the worst ten seconds play the same'
}

# The same trial gives the same row, whatever else is played.
case_trial_again() {
  expect_exit 0 contact --trial 2 --quick --json "$folder/a.json"
  expect_exit 0 contact --trial 2 --quick --json "$folder/b.json"
  cmp "$folder/a.json" "$folder/b.json" >"$out" || fail "twice the same"
  expect_line "$folder/a.json" '"trial": 2'
  expect_exit 0 stability --trial 12 --json "$folder/a.json"
  expect_line "$out" '^stability --trial 12 --seed 1: '
  expect_exit 0 stability --trial 12 --json "$folder/b.json"
  cmp "$folder/a.json" "$folder/b.json" >"$out" || fail "twice the same"
  expect_line "$folder/a.json" '"trial": 12'
  WOBBLE_ISA=avx2 expect_exit 0 stability --trial 12 --json "$folder/b.json"
  expect_line "$folder/b.json" '"isa": "avx2"'
  diff <(grep -v '"isa"' "$folder/a.json") <(grep -v '"isa"' "$folder/b.json") >"$out" || fail "the same with AVX2"
}

# Exit code 0 says that all figures keep their limits.
expect_report() { # NAME "KEY..." "PLOT..." OPTION...
  expect_exit 0 "$1" --quick --json "$folder/$1.json" --plot "$folder/plots" "${@:4}"
  local each
  for each in cpu isa compiler commit rows summary $2; do expect_line "$folder/$1.json" "\"$each\": "; done
  for each in $3; do expect_line "$folder/plots/$each.svg" '^</svg>'; done
}

case_accuracy() {
  local keys="reference_agreement exact_solution_error_max young_modulus_error speedup_vs_odeint"
  keys+=" order_rk4 order_velocity_verlet order_velocity_verlet_damped order_leap_frog order_leap_frog_damped"
  keys+=" order_semi_implicit_euler order_explicit_euler order_implicit_euler"
  keys+=" error_target_met error_target_overhead error_target_met_in_contact error_target_met_bounce"
  keys+=" error_target_met_slide error_target_met_stack error_target_met_squeeze error_target_met_cloth_over_ball"
  keys+=" error_target_met_crowd order_rk4_in_contact order_rk4_between_bodies"
  keys+=" scene_error_ball_drop scene_error_cloth scene_error_scrum scene_error_jelly_stack"
  expect_report accuracy "$keys" \
    "accuracy_work_precision accuracy_work_precision_damped accuracy_float_floor accuracy_energy accuracy_error_target
    accuracy_scenes accuracy_contact_bounce accuracy_contact_slide laws"
}

case_capacity() {
  local keys="players_at_60hz tick_ms_p99 overrun_share kbit_per_client wall_tick_ms_p99 displayed_error"
  keys+=" input_to_snapshot_ms_p50 snapshot_age_ms_p99 touching largest_group bots_core_share late_ms_p99"
  keys+=" receive_ms step_ms capture_ms encode_ms send_ms load_level"
  keys+=" relevant_error relevant_left_out relevant_error_wide relevant_left_out_wide two_threads_ratio"
  expect_report capacity "$keys" "capacity_ticks capacity_clients"
}

case_codec() {
  local keys="speed_median deformation_median bits_per_vertex_01 bits_per_vertex_025 bits_per_vertex_05 bits_at_rest"
  keys+=" ratio_vs_rigs_of_rods ratio_vs_draco ratio_vs_meshopt_zstd ratio_vs_delta_zstd ratio_vs_delta_acknowledged basis_kb"
  keys+=" vertex_error_p999_025 encode_us_per_body encode_alone_us_per_body decode_us_per_body"
  keys+=" cloth_bits_per_vertex_025 lattice_bits_per_vertex_025"
  expect_report codec "$keys" "codec_curves"
}

case_link() {
  expect_exit 0 link --quick --json "$folder/link.json" --plot "$folder/plots"
  if grep -q 'permits no network namespaces' "$out"; then return; fi
  local keys="clean_native_delay_ms_p50 clean_native_join_ms clean_page_delay_ms_p50 clean_page_delay_ms_p99"
  keys+=" clean_page_stalls_per_minute clean_page_gaps_per_minute clean_page_join_ms"
  local each
  for each in rows summary $keys; do expect_line "$folder/link.json" "\"$each\": "; done
  expect_line "$folder/plots/link.svg" '^</svg>'
}

case_interpolation() {
  local keys="displayed_error_30hz_clean displayed_error_30hz_loss5_jitter20 kbit_per_body_30hz kbit_per_body_30hz_sent"
  keys+=" display_delay_ms_clean display_delay_ms_jitter stalls_share disconnects speed_median truth_error_of_half"
  keys+=" budget_physics budget_codec budget_interpolation budget_displayed"
  expect_report interpolation "$keys" "interpolation_links"
}

case_contact() {
  expect_report contact \
    "bounce_error slide_angle_error_deg momentum_drift stack_drift stack_asleep_s tunnelled
     scene_intersecting_fine scene_intersecting_within trial_intersecting_fine trial_intersecting_others" \
    "bounce laws slide penetration"
}

# By a judge of depths who is stricter than the engine, so that there are random trials that fail: each is recorded.
case_stability() {
  expect_report stability \
    "theory_deviation_max server_step_over_limit_max perturbation_rk4_left growth_over_bound_max
     random_trials non_finite inverted_after_2s quarantined penetration_p999" \
    "stability_limits stability_map stability_perturbation stability_growth stability_trials" \
    --depth 0.2 --recordings "$folder/recordings"
  expect_line "$out" ', too deep at tick [1-9][0-9]*: .*; wobble watch '
  [ "$(find "$folder/recordings" -name '*.wobrec' | wc -l)" -eq "$(grep -c '; wobble watch ' "$out")" ] ||
    fail 'a recording of each trial that fails'
  expect_recording "$folder/stability.json"
}

case_throughput() {
  local keys="peak_gflops ns_per_vertex_step plain_ns_per_vertex_step speedup_vs_plain peak_share lone_ratio"
  keys+=" vertex_ticks_per_s thread_scaling_2 speedup_vs_bullet touching_ms_per_tick speedup_vs_bullet_touching"
  keys+=" ladder_lanes_filled ladder_cost lattice_exponent_3d gas_exponent_3d lattice_exponent_2d gas_exponent_2d"
  expect_report throughput "$keys" \
    "throughput_lanes throughput_ladder throughput_sizes throughput_crowds"
}

# Times of microseconds, which must be taken on a quiet machine.
case_skip() {
  expect_report skip asleep_ratio skip_asleep --part asleep
  expect_report skip apart_ratio "" --part search
  expect_report skip empty_cpu "" --part nobody
}

# The report's other parts, which count instructions and ticks, or whose limits are for the full run.
case_skip_counted() {
  expect_report skip term_ratio_max "" --part terms
  expect_report skip settle_s "" --part settling
  expect_report skip "recording_core_share recording_tick_ms_p99 recording_mb_per_hour seek_ms_p99" "" --part recording
}

declare -F "case_$case_name" >/dev/null || {
  echo "lab_test.sh: no case '$case_name'"
  exit 1
}
"case_$case_name"
