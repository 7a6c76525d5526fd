"""Robots: what MuJoCo's parser makes of MJCF and URDF, said in bodies, shapes and joints."""
