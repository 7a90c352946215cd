const float brightest = 2.0;  // light of the sky's texture where it is 1; it stores square roots
