#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The command as its users meet it: exit status, messages, files. Each case_NAME is one CTest entry.
#   run.sh CASE CELLIST SHARED_DIR SCRATCH_DIR
set -uo pipefail
case=$1 cellist=$2 shared=$3 scratch=$4/$1
here=$(cd "$(dirname "$0")" && pwd)
export XDG_CACHE_HOME=$scratch/cache
rm -rf "$scratch" && mkdir -p "$scratch" && cd "$scratch" || exit 1

fail() {
  echo "FAILED: $*"
  [ -f out ] && sed 's/^/  out: /' out | head -5
  [ -f err ] && sed 's/^/  err: /' err | head -5
  exit 1
}
# expect STATUS arguments...: runs cellist; standard output in ./out, standard error in ./err.
expect() {
  local status=$1
  shift
  "$cellist" "$@" >out 2>err </dev/null
  local got=$?
  [ $got -eq "$status" ] || fail "cellist $*: exit $got instead of $status"
}
says() { grep -qF -- "$1" err || fail "standard error does not say '$1'"; }
one_line() { [ "$(wc -l <err)" -eq 1 ] || fail "standard error has not exactly one line"; }
# json EXPRESSION: a Python expression over j, the object on standard output.
json() {
  python3 -c "import json,sys,math; j=json.load(open('out')); sys.exit(0 if ($1) else 1)" || fail "JSON: not $1"
}

# For cases that draw with OpenGL: a build without it skips them.
needs_opengl() {
  "$cellist" render sample:grid -o probe.png --renderer faces --size 8x8 >out 2>err && return
  grep -q "this build has no OpenGL" err || fail "no OpenGL"
  echo "skipped: this build has no OpenGL"
  exit 77
}

case_usage_is_wrong_exit_2() {
  expect 2 && expect 2 nonsense && expect 2 render && expect 2 render sample:grid
  expect 2 render sample:grid -o a.bmp
  says "ends in .exr or .png"
  expect 2 render sample:grid -o a.png --size 0x10
  expect 2 render sample:grid -o a.png --no-such-option
  says "no option --no-such-option"
  expect 2 render sample:grid -o a.png --renderer painter
  says "faces"
  expect 2 render sample:grid -o a.png --eye 1,2
  expect 2 render sample:grid -o a.png --eye 1,2,3 --orbit 1,2
  expect 2 render sample:grid -o a.png --fovy 180
  expect 2 render sample:grid -o a.png --unit diagonal/0
  expect 2 render sample:grid -o a.png --parallel 0
  expect 2 render sample:grid -o a.png --size
  says "--size needs an argument"
  expect 2 generate gears
  expect 2 info
  [ ! -e a.png ] || fail "a picture was written"
}

case_render_clips_and_shows_surfaces() {
  printf 'v 0 0 0.5\nv 9 0 0.5\nv 0 9 0.5\nv -9 -9 0.5\nf 1 2 3\nf 1 3 4\nf 1 4 2\n' >plane.obj
  local camera=(--size 32x32 --orbit 20,60)
  expect 0 render sample:grid:500 -o plain.exr "${camera[@]}"
  for renderer in cast soft; do
    expect 0 render sample:grid:500 -o none.exr "${camera[@]}" --renderer $renderer --clip 0,0,1,-5
    expect 0 compare none.exr none.exr --json
    json 'j["covered_pixels"] == 0'
    expect 0 render sample:grid:500 -o same.exr "${camera[@]}" --renderer $renderer --clip=-9,-9,-9,9,9,9
    expect 0 compare same.exr plain.exr --json
    json 'j["max_abs"] < 1e-4 and j["covered_pixels"] > 100'
    expect 0 render sample:grid:500 -o solid.exr "${camera[@]}" --renderer $renderer --surface boundary,1,0,0
    expect 0 compare solid.exr plain.exr --json
    json 'j["max_abs"] > 0.1'
  done
  expect 0 render sample:grid:500 -o a.exr "${camera[@]}" --surface plane.obj,0.2,0.5,1 --surface 'cells:wave=..0.2' \
    --surface ids:0+5..9
  expect 2 render sample:grid -o a.png --clip 1,2,3
  says "--clip needs a plane"
  expect 2 render sample:grid -o a.png --clip 0,0,0,1
  expect 2 render sample:grid -o a.png --clip 1,1,1,0,0,0
  says "lower corner first"
  expect 2 render sample:grid -o a.png --surface plane.obj,-1,0,0
  expect 1 render sample:grid -o b.png --surface missing.stl
  says "missing.stl: No such file"
  expect 1 render sample:grid -o b.png --surface cells:nothing=1..2
  says "no scalar 'nothing'"
  expect 1 render sample:grid -o b.png --surface cells:wave=2..1
  says "cells:SCALAR=LO..HI"
  expect 1 render sample:grid -o b.png --surface ids:x
  says "ids:ID+ID..ID"
  [ ! -e b.png ] || fail "a picture was written"
}

case_sort_writes_orders_and_figures() {
  expect 0 sort sample:gears --orbit 30,20 --order order.txt --verify 300 --peer centroid --peer mpvo_nc --json
  json 'j["order"] == "exact" and j["unsorted"] == 0 and j["inversions"] == 0 and j["pairs"] > 300'
  json 'j["violations"] == 0 and all(p["violations"] > 0 for p in j["peers"] if p["name"] == "centroid")'
  json 'j["peers"][0]["name"] == "centroid" and j["peers"][0]["inversions"] > 0 and j["peers"][1]["pairs"] > 0'
  local tets
  tets=$(python3 -c "import json; print(json.load(open('out'))['tets'])")
  [ "$(grep -c '^[0-9]* [0-9]*$' order.txt)" -eq "$tets" ] || fail "order.txt has not one line a tet"
  [ "$(grep '^[0-9]' order.txt | sort -u | wc -l)" -eq "$tets" ] || fail "order.txt names a tet twice"
  expect 0 sort sample:grid --views 3 --repeat 2 --parallel 2 --threads 2
  grep -q "order: exact" out || fail "no text"
  expect 0 sort sample:grid --order -
  [ "$(wc -l <out)" -gt 100 ] || fail "no order on standard output"
  expect 2 sort sample:grid --peer bubble
  says "--peer is one of"
  expect 2 sort sample:grid --views 2 --order order.txt
  expect 2 sort sample:grid --order - --json
  expect 1 sort sample:grid --order /nonexistent/order.txt
  says "cannot be written"
  expect 1 sort nothing.vtu
  one_line
}

case_exteriors_are_chosen_and_kept() {
  local exterior
  for exterior in none hull box grid delaunay; do
    expect 0 sort sample:gears:2000 --exterior $exterior --views 3 --verify 600 --json --no-cache
    json "j['exterior'] in ('$exterior', 'hull') and j['unsorted'] == 0 and j['inversions'] == 0 and j['pairs'] > 0"
    json "not j['cached'] and (j['imaginary_cells'] > 0) == ('$exterior' != 'none')"
  done
  [ ! -e "$XDG_CACHE_HOME" ] || fail "--no-cache wrote something"
  expect 0 sort sample:gears:2000 --json
  json "j['exterior'] != 'auto' and 'plain sort = 1' in j['exterior_reason'] and not j['cached']"
  cp out first
  [ "$(ls "$XDG_CACHE_HOME/cellist"/*.cells | wc -l)" -eq 1 ] || fail "the exterior is not kept"
  expect 0 sort sample:gears:2000 --json
  json "j['cached'] and all(j[k] == json.load(open('first'))[k] for k in ('exterior', 'exterior_reason', 'imaginary_cells'))"
  expect 0 render sample:gears:2000 -o a.exr --renderer soft --tf viridis --size 32x32 --cache mine --json
  json "j['exterior'] == 'none' and '1 picture would not pay' in j['exterior_reason']"
  [ ! -e mine ] || fail "one picture made an exterior"
  expect 0 render sample:gears:2000 -o a.exr --renderer soft --tf viridis --size 4x4 --cache mine --frames 300 --json
  json "j['exterior'] != 'none' and j['imaginary_cells'] > 0 and 'exterior_reason' in j"
  [ "$(ls mine/*.cells | wc -l)" -eq 1 ] || fail "--cache is not used"
  expect 0 render sample:gears:2000 -o a.exr --renderer cast --size 32x32 --cache other
  [ ! -e other ] || fail "an exterior was made where no order is needed"
  expect 0 sort sample:grid --json
  json "j['exterior'] == 'none' and 'convex' in j['exterior_reason']"
  expect 0 sort sample:gears:2000 --cache /dev/null/cellist --json
  says "cannot be written"
  expect 0 sort sample:gears:2000 --gaps complex --json
  json "j['imaginary_cells'] > 0"
  expect 0 sort sample:gears:2000 --gaps overlap --json
  json "j['exterior'] == 'none' and j['gap_arcs'] > 0"
  expect 2 sort sample:gears --gaps overlap --exterior hull
  expect 2 sort sample:gears --exterior sphere
  expect 2 sort sample:gears --cache a --no-cache
}

case_help_and_version() {
  expect 0 --help && grep -q render out || fail "no overview"
  expect 0 --version && grep -Eq '^cellist [0-9]+\.[0-9]+\.[0-9]+$' out || fail "no version"
  for command in info generate convert convexify sort render compare report; do
    expect 0 $command --help
    grep -q '^examples:' out || fail "$command --help has no examples"
  done
}

case_bad_input_exit_1_with_one_line() {
  expect 1 render missing.vtu -o a.png && says "missing.vtu" && one_line
  : >empty.vtu
  expect 1 render empty.vtu -o a.png && says "empty.vtu" && one_line
  echo "this is no mesh" >text.vtu
  expect 1 render text.vtu -o a.png && says "text.vtu" && one_line
  head -c 100000 /dev/urandom >noise.vtu
  expect 1 info noise.vtu && says "noise.vtu" && one_line
  expect 1 render . -o a.png && one_line
  expect 0 generate grid -o grid.vtu
  size=$(stat -c %s grid.vtu)
  for part in 1 2 3 4 5 6 7 8 9; do
    head -c $((size * part / 10)) grid.vtu >cut.vtu
    expect 1 render cut.vtu -o a.png && says "cut.vtu" && one_line
  done
  expect 1 render grid.vtu -o a.png --scalar nonsense && says "no scalar 'nonsense'" && one_line
  expect 1 render grid.vtu -o a.png --tf nonsense && says "nonsense" && one_line
  echo "{ not JSON" >bad.json
  expect 1 render grid.vtu -o a.png --tf bad.json && says "bad.json" && one_line
  expect 1 render grid.vtu -o no/such/folder/a.png && says "no/such/folder/a.png" && one_line
  expect 1 render sample:nonsense -o a.png && says "nonsense" && one_line
  expect 1 render grid.vtu -o a.png --up 0,0,1 --eye 0,0,5 --target 0,0,0 && one_line
  [ ! -e a.png ] || fail "a picture was written"
}

case_render_writes_pictures_and_json() {
  needs_opengl
  for renderer in faces soft cast; do
    expect 0 render sample:gears -o a.exr -o a.png --renderer $renderer --size 96x64 --frames 3 --json
    json "j['renderer'] == '$renderer' and j['width'] == 96 and j['height'] == 64 and j['frames'] == 3"
    json "all(j['seconds'][k] >= 0 for k in ('load', 'convexify', 'sort', 'draw', 'total'))"
    json "j['fragments'] > 0 and j['tf_entries'] >= 2 and j['opacity_convention'] == 'unstructured'"
    json "isinstance(j['left_out'], list)"
    [ -s a.exr ] && [ -s a.png ] || fail "no picture"
    rm a.exr a.png
  done
  expect 0 render sample:gears -o - --size 32x32
  [ "$(head -c 4 out | od -An -tx1 | tr -d ' \n')" = 762f3101 ] || fail "standard output is not EXR"
}

case_explain_says_what_was_left_out() {
  expect 0 render sample:torus -o a.exr --renderer soft --tf spikes --explain --json --size 64x64
  json "[p['what'] for p in j['plan']] == j['left_out'] and all(p['why'] for p in j['plan'])"
  json "'invisible cells' in j['left_out'] and 0 < j['visible_cells'] < j['cells']"
  json "all(k in j['seconds_without_plan'] for k in ('load', 'convexify', 'prepare', 'sort', 'draw', 'total'))"
  expect 0 render sample:torus -o b.exr --renderer soft --tf spikes --no-plan --json --size 64x64
  json "'invisible cells' not in j['left_out'] and j['visible_cells'] == j['cells'] and 'plan' not in j"
  expect 0 compare a.exr b.exr --json
  json "j['max_abs'] <= 1e-5 and j['covered_pixels'] > 100"
  expect 0 render sample:torus -o a.png --renderer soft --model absorption --explain --size 64x64
  grep -q "no sort  *absorption alone commutes" out || fail "no explanation"
  expect 2 render sample:torus -o a.png --explain --no-plan
}

case_framebuffers_cost_their_rounding() {
  needs_opengl
  expect 0 render sample:ball -o cast.exr --renderer cast --size 256x256
  for bits in 32f 16f 8; do
    expect 0 render sample:ball -o $bits.exr --renderer faces --framebuffer $bits --size 256x256 --json
    json "j['framebuffer'] == '$bits'"
    expect 0 compare $bits.exr cast.exr --json
    mv out $bits.json
  done
  python3 -c "
import json, sys
e = [json.load(open(n + '.json'))['rmse'] for n in ('32f', '16f', '8')]
sys.exit(0 if e[0] < 1e-5 < e[1] < 5e-3 and e[1] < e[2] < 3e-2 else str(e))" || fail "errors are not of that size"
  expect 2 render sample:ball -o a.exr --framebuffer 24
}

# A window is opened on a display that only this test sees.
case_a_desktop_s_context_draws_the_same() {
  needs_opengl
  command -v Xvfb >/dev/null || { echo "skipped: no Xvfb" && exit 77; }
  env -u DISPLAY "$cellist" render sample:torus -o none.exr --renderer faces --context glfw --size 64x64 >out 2>err \
    && fail "a window without a display"
  grep -q "not built in" err && { echo "skipped: built without GLFW" && exit 77; }
  says GLFW
  Xvfb -displayfd 3 -screen 0 64x64x24 -nolisten tcp 3>display >xvfb.log 2>&1 &
  local server=$!
  trap "kill $server" EXIT
  for _ in $(seq 100); do [ -s display ] && break || sleep 0.1; done
  [ -s display ] || fail "Xvfb does not start: $(cat xvfb.log)"
  DISPLAY=:$(cat display) expect 0 render sample:torus -o glfw.exr --renderer faces --context glfw --size 128x128 --json
  json "j['context'] == 'glfw'"
  expect 0 render sample:torus -o auto.exr --renderer faces --size 128x128
  expect 0 compare glfw.exr auto.exr --json
  json "j['max_abs'] <= 1e-5 and j['covered_pixels'] > 500"
}

case_a_budget_chooses_how_to_draw() {
  expect 0 render sample:torus -o reference.exr --renderer cast --precision reference --size 128x128
  local last=0
  for error in 1e-2 1e-5 1e-6 1e-11; do
    expect 0 render sample:torus -o a.exr --error $error --size 128x128 --json
    json "j['choice']['expected_error'] <= $error and j['choice']['expected_seconds'] >= $last"
    last=$(python3 -c "import json; print(json.load(open('out'))['choice']['expected_seconds'])")
    expect 0 compare a.exr reference.exr --json
    json "j['rmse'] <= $error and j['covered_pixels'] > 1000"
  done
  expect 0 render sample:torus -o a.exr --time 100 --size 128x128 --json
  json "j['precision'] == 'reference'"
  expect 0 render sample:torus -o a.exr --time 1e-9 --size 128x128
  says "even the fastest setting"
  grep -q "chosen: " out || fail "the choice is not said"
  expect 1 render sample:torus -o b.exr --error 1e-15 --size 128x128 && says "an error of 1e-15 was asked for" && one_line
  expect 2 render sample:torus -o b.exr --error 1e-3 --time 1
  expect 2 render sample:torus -o b.exr --error 1e-3 --renderer soft
  expect 1 render missing.vtu -o b.exr --time 1 && says missing.vtu && one_line
  [ ! -e b.exr ] || fail "a picture was written"
}

# A report is read by people, spreadsheets and programs: all three files hold the same, and the page stands alone.
case_report_is_whole() {
  needs_opengl
  command -v gnuplot >/dev/null || { echo "skipped: no gnuplot" && exit 77; }
  printf 'name,mesh,seconds,rmse\n"other, 1",sample_grid,0.5,0.01\n' >peer.csv
  expect 0 report sample:grid sample:l-shape -o "a report" --size 48x40 --frames 1 --peer peer.csv --json
  json "j['meshes'] == 2 and j['drawn'] > 30"
  python3 - "a report" <<'END' || fail "the report is not whole"
import csv, json, sys, os, xml.dom.minidom
from html.parser import HTMLParser
folder = sys.argv[1]
data = json.load(open(folder + '/report.json'))
rows = list(csv.DictReader(open(folder + '/report.csv')))
assert len(rows) == len(data['rows']) and len({(r['mesh'], r['setting']) for r in rows}) == len(rows)
for a, b in zip(rows, data['rows']):
    assert (a['mesh'], a['setting']) == (b['mesh'], b['setting'])
    if b['drawn']:
        assert abs(float(a['rmse']) - b['rmse']) <= 1e-6 * b['rmse'] and b['seconds']['frame'] > 0 and b['ssim'] <= 1.0000001
        assert b['rmse'] < 0.3 and b['covered_pixels'] > 50
    else:
        assert b['message']
exact = [r for r in data['rows'] if r['setting'] in ('soft', 'faces', 'cast fast', 'faces psi')]
assert len(exact) == 8 and all(r['rmse'] < 1e-5 for r in exact)
assert any(r['pareto'] for r in data['rows']) and data['machine']['cellist'] == data['version']
class Page(HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.pictures, self.charts = [], 0, 0
    def handle_starttag(self, tag, attributes):
        if tag == 'img':
            self.pictures += dict(attributes)['src'].startswith('data:image/png;base64,iVBOR')
        elif tag not in ('meta', 'br'):
            self.open.append(tag)
        self.charts += tag == 'svg'
    def handle_endtag(self, tag):
        if tag in self.open:
            while self.open.pop() != tag: pass
page = Page()
page.feed(open(folder + '/report.html').read())
drawn = sum(r['drawn'] for r in data['rows'])
assert page.pictures == 2 * drawn and page.charts == 2 and page.open == [], (page.pictures, page.charts, page.open)
for mesh in ('sample_grid', 'sample_l_shape'):
    xml.dom.minidom.parse(folder + '/charts/' + mesh + '.svg')
assert 'other, 1' in open(folder + '/charts/sample_grid.svg').read()
assert not os.path.exists(folder + '/report.rows')
END
  expect 0 report sample:grid -o stable --size 16x16 --frames 1 --stability
  python3 - <<'END' || fail "the stability page is not whole"
import json
rows = json.load(open('stable/report.json'))['stability']
assert len(rows) > 200 and {r['judged by'] for r in rows} >= {'cast', 'soft', 'faces', 'order'}
assert all(r['verdict'] in ('passes', 'known', 'refused') for r in rows), [r for r in rows if r['verdict'] == 'fails']
assert all(r['must'] and r['exercises'] and (r['verdict'] == 'passes' or r['says']) for r in rows)
page = open('stable/report.html').read()
assert all('>' + r['case'] + '<' in page for r in rows)
END
  printf 'mesh,name,seconds,rmse\nx,y,fast,1\n' >peer.csv
  expect 1 report sample:grid -o b --size 32x32 --peer peer.csv && says "peer.csv: line 2: seconds 'fast'" && one_line
  printf 'mesh,seconds\n' >peer.csv
  expect 1 report sample:grid -o b --size 32x32 --peer peer.csv && says "no column 'name'" && one_line
  expect 1 report nothing.vtu -o b --size 32x32 && says nothing.vtu && one_line
  expect 1 report sample:grid -o no/such/b --size 32x32 && says no/such/b && one_line
  expect 2 report sample:grid && says "-o DIR"
}

case_report_resumes() {
  needs_opengl
  command -v gnuplot >/dev/null || { echo "skipped: no gnuplot" && exit 77; }
  "$cellist" report sample:gears -o a --size 64x64 >out 2>err </dev/null &
  local first=$!
  for _ in $(seq 600); do [ -e a/report.rows ] && [ "$(wc -l <a/report.rows)" -gt 5 ] && break || sleep 0.1; done
  kill -9 $first
  wait $first 2>/dev/null
  [ -e a/report.rows ] && [ ! -e a/report.html ] || fail "the report was finished too early"
  cp a/report.rows rows
  expect 0 report sample:gears -o a --size 64x64
  python3 - <<'END' || fail "rows that were there were measured again"
import json
before = [json.loads(line) for line in open('rows') if line.endswith('}\n')][1:]
after = {r['setting']: r for r in json.load(open('a/report.json'))['rows']}
assert len(before) >= 4 and len(after) > len(before)
for row in before:
    assert not row['drawn'] or row['seconds'] == after[row['setting']]['seconds'], row
END
}

case_contexts_and_renderers_agree() {
  needs_opengl
  for source in sample:grid sample:ball; do
    expect 0 render $source -o osmesa.exr --renderer faces --context osmesa
    expect 0 render $source -o egl.exr --renderer faces --context egl
    expect 0 render $source -o cast.exr --renderer cast
    expect 0 compare osmesa.exr egl.exr --json
    json "j['max_abs'] <= 1e-5 and j['covered_pixels'] > 1000"
    expect 0 render $source -o soft.exr --renderer soft
    for image in osmesa soft; do
      expect 0 compare $image.exr cast.exr --json
      json "j['rmse'] < 1e-5 and j['covered_pixels'] > 1000"
    done
  done
}

case_a_mesh_without_cells_gives_an_empty_picture_and_a_word() {
  cat >surface.vtu <<'END'
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="3" NumberOfCells="1"><Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 0 1 0</DataArray></Points><Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">3</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>
END
  for renderer in soft cast; do
    expect 0 render surface.vtu -o a.exr --renderer $renderer --size 16x16
    says "no cells" && one_line
    expect 0 compare a.exr a.exr --json
    json "j['covered_pixels'] == 0"
  done
}

case_models_and_light() {
  for model in "--model absorption" "--model emission" "--model mip" "--iso 0.3,0.6" "--light headlight" \
    "--iso 0.5 --light 1,2,3" "--tets 16"; do
    # shellcheck disable=SC2086
    expect 0 render sample:gears -o a.exr --renderer cast --size 48x48 $model --json
    json "j['fragments'] > 0"
  done
  expect 2 render sample:gears -o a.exr --model iso
  says "need each other"
  expect 2 render sample:gears -o a.exr --light 1,2
  expect 2 render sample:gears -o a.exr --light 0,0,0
}

case_integration_is_chosen_and_named() {
  needs_opengl
  expect 0 render sample:gears -o exact.exr --renderer faces --size 64x64 --light headlight --samples 4 --json
  json "j['integration'] == 'exact'"
  for method in "psi=psi" "table=table 128x128x32" "table:96x96x20=table 96x96x20"; do
    expect 0 render sample:gears -o a.exr --renderer faces --size 64x64 --light headlight --samples 4 \
      --integration "${method%%=*}" --json
    json "j['integration'] == '${method#*=}' and j['renderer'] == 'faces'"
    expect 0 compare a.exr exact.exr --json
    json "0 < j['rmse'] < 2e-3"
  done
  for size in "64=64x64x64" "64x24=64x64x24"; do
    expect 0 render sample:gears -o a.exr --renderer faces --size 8x8 --integration "table:${size%%=*}" --json
    json "j['integration'] == 'table ${size#*=}'"
  done
  expect 0 render sample:gears -o a.exr --size 32x32 --integration psi --json
  json "j['renderer'] == 'faces'"
  expect 0 render sample:gears -o a.exr --size 32x32 --renderer cast --integration psi --json
  json "j['integration'] == 'exact'"
  says "integrates exactly"
  expect 0 render sample:gears -o a.exr --size 32x32 --renderer faces --model mip --integration table --json
  json "j['integration'] == 'exact'"
  for tf in ramp spikes; do
    expect 0 render sample:gears -o a.exr --size 32x32 --renderer faces --tf $tf --integration table
    grep -q "spikes or steps" err && found=spikes || found=ramp
    [ $found = $tf ] || fail "the warning of coarse tables is wrong for $tf"
  done
  for size in 1 4x2 8x9x10 1025 8x 8xx 8,8 ""; do
    expect 2 render sample:gears -o a.exr --integration "table:$size"
  done
  expect 2 render sample:gears -o a.exr --integration simpson
  expect 2 render sample:gears -o a.exr --samples 5
}

case_isosurfaces_have_opacities() {
  needs_opengl
  expect 0 render sample:gears -o a.exr --renderer cast --size 64x64 --iso 0.35,0.5 --iso-opacity 1,0.3 --light headlight
  expect 0 render sample:gears -o b.exr --renderer faces --size 64x64 --iso 0.35,0.5 --iso-opacity 1,0.3 --light headlight
  expect 0 compare b.exr a.exr --json
  json "j['rmse'] < 1e-4"
  expect 0 render sample:gears -o b.exr --renderer cast --size 64x64 --iso 0.35,0.5 --light headlight
  expect 0 compare b.exr a.exr --json
  json "j['rmse'] > 1e-2"
  expect 2 render sample:gears -o a.exr --iso 0.5 --iso-opacity 2
  expect 2 render sample:gears -o a.exr --iso 0.5,0.6,0.7 --iso-opacity 0.1,0.2
  expect 2 render sample:gears -o a.exr --iso-opacity 0.5
}

case_turntable_writes_numbered_pictures() {
  expect 0 render sample:gears -o 'turn%04d.png' --turntable 3 --size 32x32 --renderer cast
  [ "$(ls turn*.png | tr '\n' ' ')" = "turn0000.png turn0001.png turn0002.png " ] || fail "not three pictures"
  cmp -s turn0000.png turn0001.png && fail "the turn shows no difference"
  expect 2 render sample:gears -o turn.png --turntable 3
}

case_generate_is_deterministic() {
  expect 0 generate --list
  grep -q '^gears ' out || fail "no gears in the list"
  for name in $(awk '{print $1}' out | head -3) ball; do
    "$cellist" generate "$name" -o a.vtu 2>/dev/null && "$cellist" generate "$name" -o b.vtu 2>/dev/null
    cmp a.vtu b.vtu || fail "$name differs from run to run"
  done
  expect 0 generate ball -o a.vtu --size 20000 --seed 5 --json
  json "abs(j['tets'] - 20000) <= 2000"
  expect 0 generate plates -o a.vtu --parts 7 && expect 0 info a.vtu --json
  json "j['components'] == 7"
  expect 0 generate grid -o a.vtu --size 50000 --json
  json "abs(j['tets'] - 50000) <= 5000"
}

case_info_tells_what_is_in_the_file() {
  expect 0 generate grid -o grid.vtu --size 6000
  expect 0 info grid.vtu --json
  json "j['tets'] > 5000 and j['points'] > 1000 and j['boundary_faces'] > 0 and len(j['scalars']) >= 1"
  json "all(set(('name', 'on', 'min', 'max')) <= set(s) for s in j['scalars'])"
  expect 0 info grid.vtu && grep -q tets out || fail "no table"
}

case_convert_keeps_the_mesh() {
  expect 0 generate gears -o gears.vtu
  expect 0 convert gears.vtu copy.vtu
  expect 0 render gears.vtu -o a.exr --renderer cast --size 64x64
  expect 0 render copy.vtu -o b.exr --renderer cast --size 64x64
  expect 0 compare a.exr b.exr --json
  json "j['max_abs'] == 0"
}

case_compare_measures() {
  expect 0 render sample:grid -o a.exr --renderer cast --size 64x64
  expect 0 render sample:grid -o b.exr --renderer cast --size 64x64 --opacity-scale 1.2
  expect 0 compare a.exr b.exr --json
  json "all(k in j for k in ('width', 'height', 'covered_pixels', 'rmse', 'max_abs', 'psnr', 'ssim', 'pixels_over_2_255'))"
  json "0 < j['rmse'] <= j['max_abs'] < 1"
  expect 1 compare a.exr missing.exr && says missing.exr && one_line
}

# Pictures of earlier versions, by the reference caster; tests/golden/renew makes them anew.
case_golden_pictures_stay_as_they_are() {
  while read -r name options; do
    # shellcheck disable=SC2086
    expect 0 render $options --renderer cast --precision reference -o "$name.exr"
    expect 0 compare "$name.exr" "$here/../golden/$name.exr" --json
    json "j['max_abs'] <= 1e-6 and j['covered_pixels'] > 300"
    case $options in *--iso*) continue ;; esac
    # shellcheck disable=SC2086
    expect 0 render $options --renderer cast --precision fast -o "$name.exr"
    expect 0 compare "$name.exr" "$here/../golden/$name.exr" --json
    json "j['rmse'] <= 2e-4"
  done <"$here/../golden/pictures.txt"
}

case_convexify_keeps_its_result() {
  "$cellist" convexify --help >/dev/null 2>&1 || { echo "skipped: this build has no convexifier" && exit 77; }
  expect 2 convexify sample:gears
  says "-o FILE.cells is missing"
  expect 2 convexify sample:gears -o a.cells --exterior sphere
  expect 0 convexify sample:gears -o a.cells --json
  json "j['imaginary_cells'] > 100 and j['volume_error'] < 1e-12 and j['convexity_violations'] == 0 and not j['cached']"
  cp a.cells first.cells
  expect 0 convexify sample:gears -o a.cells --json
  json "j['cached'] and j['imaginary_cells'] > 100 and j['cuts'] > 0 and j['seconds'] < 60 and j['peak_mb'] > 1"
  cmp -s a.cells first.cells || fail "reading changed the file"
  expect 0 convexify sample:l-shape -o l.cells --movie film --flat 1 --json
  [ -s film/0000.png ] && [ -s film/0001.png ] && [ ! -e film/0002.png ] || fail "pictures of the cutting are missing"
  expect 0 convexify sample:gears -o a.cells --exterior grid --json
  json "j['exterior'] == 'grid' and not j['cached']"
  expect 0 convexify sample:gears -o c.cells --exterior auto --seed 3 --json
  json "j['exterior'] in ('delaunay', 'hull', 'grid') and 'least work of' in j['exterior_reason'] and not j['cached']"
  json "j['exterior'] in j['exterior_reason'] and j['imaginary_cells'] > 100 and j['volume_error'] < 1e-12"
  grep -q "least work of" c.cells || fail "the reason is not in the file"
  python3 -c "import json; print(json.load(open('out'))['exterior_reason'])" >reason
  cp c.cells first.cells
  expect 0 convexify sample:gears -o c.cells --exterior auto --seed 3
  grep -q "read from the file" out || fail "the choice was made again"
  grep -qF "($(cat reason))" out || fail "the reason is not shown"
  cmp -s c.cells first.cells || fail "reading changed the file"
  expect 0 convexify sample:gears -o c.cells --exterior auto --seed 4 --json
  json "not j['cached']"
  expect 1 convexify sample:flaws -o d.cells --exterior auto
  says "cell"
  [ ! -e d.cells ] || fail "a file without a complex was left"
  expect 0 convexify sample:grid -o e.cells --exterior auto
  grep -q "(the mesh is convex)" out || fail "a box of cubes is convex"
  expect 0 convexify sample:grid -o b.cells
  grep -q "imaginary cells   0" out || fail "a box of cubes is convex"
  expect 1 convexify sample:grid -o no/such/folder/a.cells
  says "cannot be written"
}

case_full_disk_and_unwritable_output() {
  [ -e /dev/full ] || exit 77
  "$cellist" render sample:grid -o - --size 64x64 >/dev/full 2>err && fail "a full disk went unnoticed"
  says "standard output"
  "$cellist" info sample:grid >/dev/full 2>err && fail "a full disk went unnoticed"
  true
}

case_real_meshes_render() {
  [ -d "$shared/data" ] || { echo "skipped: $shared/data is not there" && exit 77; }
  needs_opengl
  for mesh in spx bluntfin post impeller gears_t sci_torso disk_out_ref fire bucky; do
    for context in osmesa egl; do
      expect 0 render "$shared/data/$mesh.vtu" -o $context.exr --renderer faces --context $context --unit diagonal/50 \
        --size 128x128
    done
    expect 0 compare osmesa.exr egl.exr --json
    json "j['max_abs'] <= 1e-5 and j['covered_pixels'] > 500"
  done
}

declare -F "case_$case" >/dev/null || { echo "no case $case" && exit 1; }
"case_$case"
