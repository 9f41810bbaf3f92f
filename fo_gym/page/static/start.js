/* The last script: everybody listens now. */
"use strict";
fg.start();
