# Makes the files that the pages of the guide use, in the current folder. $1 is the sample recording.

cp "$1" tracks.csv
awk -F, 'NR > 1 { printf "{\"track\": {\"f\": %d, \"p\": %d, \"x\": %s, \"y\": %s}}\n", $1, $2, $3 + 0, $4 + 0 }' \
    tracks.csv > tracks.ndjson
awk 'BEGIN {
    print "{\"scene\": {\"id\": 0, \"p\": 3, \"s\": 0, \"e\": 190}}"
    row = "{\"track\": {\"f\": %d, \"p\": 3, \"x\": %s, \"y\": 12, \"prediction_number\": 0, \"scene_id\": 0}}\n"
    for (t = 1; t <= 12; t++) printf row, 70 + 10 * t, 7.7 - 0.5 * t
}' > forecasts.ndjson
awk -F, -v OFS=, 'NR > 1 { $3 = ($3 + 5) / 0.02; $4 = (12 - $4) / 0.02 } { print }' tracks.csv > pixels.csv
printf '0.02 0 -5\n0 -0.02 12\n0 0 1\n' > H.txt
# Every fifth frame sees every other pedestrian.
awk -F, 'NR == 1 || $1 % 5 != 2 || $2 % 2 == 0' tracks.csv > holes.csv
printf 'time,id,x,y\n0,1,0.00,2.00\n1,1,0.52,2.01\n2,1,1.03,2.03\n' > named.csv
cat > walk.csv <<'END'
frame,pedestrian,x,y
0,1,0.00,2.00
0,2,8.00,2.50
1,1,0.52,2.01
1,2,7.41,2.49
2,1,1.03,2.03
2,2,6.83,2.51
3,1,1.55,2.02
3,2,6.25,2.52
END

# The first $1 frames of the sample from a camera with $2 frames per step.
filmed() {
    head -n 1 tracks.csv
    awk -F, -v OFS=, -v last="$1" -v n="$2" '
        NR > 1 && $1 < last { x[$1, $2] = $3; y[$1, $2] = $4 }
        END {
            for (key in x) {
                split(key, row, SUBSEP)
                after = row[1] + 1 SUBSEP row[2]
                print n * row[1], row[2], x[key], y[key]
                for (i = 1; after in x && i < n; i++)
                    print n * row[1] + i, row[2], x[key] + i / n * (x[after] - x[key]), y[key] + i / n * (y[after] - y[key])
            }
        }' tracks.csv | sort -t , -k 1,1n -k 2,2n
}
filmed 1000000 10 > camera.csv
filmed 10 4 > tracker.csv
awk 'NR == 1 { print "scene," $0; next } { print "hall," $0; print "yard," $0 }' tracker.csv > cameras.csv

# The programs of the pages that print tracks as they come.
inputs=$PWD
tracker() { cat "$inputs/tracker.csv"; }
cameras() { cat "$inputs/cameras.csv"; }
export inputs
export -f tracker cameras
