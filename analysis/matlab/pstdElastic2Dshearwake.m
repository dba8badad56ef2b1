function sensor_data = pstdElastic2Dshearwake(kgrid, medium, source, sensor, varargin)
%PSTDELASTIC2DSHEARWAKE Runs a simulation of pstdElastic2D of k-Wave with shearwake.
%   sensor_data = pstdElastic2Dshearwake(kgrid, medium, source, sensor, ...) has the arguments and the result of
%   pstdElastic2D, and works without k-Wave: kgrid may be a struct with Nx, Ny, dx, dy and dt, Nt or t_array.
%   The further options are those of pstdElastic3Dshearwake.
%   SPDX-License-Identifier: BSD-3-Clause
sensor_data = pstdElastic3Dshearwake(kgrid, medium, source, sensor, varargin{:}, 'Dimensions', 2);
end
