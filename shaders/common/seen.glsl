// What a blended surface shows of itself: less is not looked for, neither by the depths that tiles state
// nor by the full render they are held against.
const float kSeenAlpha = 1.0 / 16.0;
