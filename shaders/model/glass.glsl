const float GLASS = 0.04;  // reflectance of plastic, glass and clear coats at normal incidence
