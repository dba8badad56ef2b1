function sensor_data = pstdElastic3Dshearwake(kgrid, medium, source, sensor, varargin)
%PSTDELASTIC3DSHEARWAKE Runs a simulation of pstdElastic3D of k-Wave with shearwake.
%   sensor_data = pstdElastic3Dshearwake(kgrid, medium, source, sensor, ...) has the arguments and the result of
%   pstdElastic3D, and works without k-Wave: kgrid may be a struct with Nx, Ny, Nz, dx, dy, dz and dt, Nt or t_array.
%   Options about plots and files are ignored. Further options:
%     'Ranks'      number of MPI ranks (default 1)
%     'Precision'  'double' (default) or 'single'; 'DataCast', 'single' has the same effect
%     'Device'     'cpu' (default) or 'gpu', a GPU with OpenCL; 'DeviceNum' is its number
%     'Program'    path of the program shearwake (default: found by its Python package)
%     'Python'     interpreter with NumPy and h5py (default 'python3')
%   Time reversal and sensor.frequency_response are not supported. MATLAB and Octave.
%   SPDX-License-Identifier: BSD-3-Clause
own = struct('Ranks', 1, 'Precision', 'double', 'Device', 'cpu', 'DeviceNum', [], 'Program', '', 'Python', 'python3', 'Dimensions', 3);
cast = 'off';
recast = false;
options = {};
for k = 1:2:numel(varargin)
    name = varargin{k};
    if k == numel(varargin)
        error('shearwake:options', 'the option %s has no value', name);
    elseif isfield(own, name)
        own.(name) = varargin{k + 1};
    elseif strcmp(name, 'DataCast')
        cast = varargin{k + 1};
    elseif strcmp(name, 'DataRecast')
        recast = varargin{k + 1};
    else
        options(end + 1:end + 2) = varargin(k:k + 1);
    end
end
is_single = strcmp(own.Precision, 'single') || ~isempty(strfind(cast, 'single')); %#ok<STREMP>
sensor_data = [];
if isempty(sensor)
    return
end

is_binary = own.Dimensions == 2 && isfield(sensor, 'mask') && isequal(size(sensor.mask), [kgrid.Nx, kgrid.Ny]);
% The structures as plain fields: the object kWaveGrid can be read by MATLAB only.
grid = struct();
for name = {'Nx', 'Ny', 'Nz', 'dx', 'dy', 'dz', 'dt', 'Nt', 't_array'}
    is_there = (isstruct(kgrid) && isfield(kgrid, name{1})) || (isobject(kgrid) && isprop(kgrid, name{1}));
    if is_there && ~isempty(kgrid.(name{1}))
        grid.(name{1}) = kgrid.(name{1});
    end
end
if isfield(grid, 'dt') && isfield(grid, 'Nt') && isfield(grid, 't_array')
    grid = rmfield(grid, 't_array');
end
folder = tempname();
mkdir(folder);
remove = onCleanup(@() rmdir_all(folder));
file = fullfile(folder, 'study.mat');
saved = struct('kgrid', grid, 'medium', medium, 'source', source, 'sensor', sensor);
if ~isempty(options)
    saved.options = options;
end
if exist('OCTAVE_VERSION', 'builtin')
    save('-hdf5', file, '-struct', 'saved');
else
    save(file, '-struct', 'saved', '-v7.3');
end

% The Python package lies next to the folder of this file.
package = fileparts(fileparts(mfilename('fullpath')));
precisions = {'double', 'single'};
command = sprintf('PYTHONSAFEPATH=1 PYTHONPATH=%s"${PYTHONPATH:+:$PYTHONPATH}" %s -m shearwake.kwave %s %s --ranks %d --precision %s --dimensions %d 2>&1', ...
    quoted(package), quoted(own.Python), quoted(file), quoted(folder), own.Ranks, precisions{1 + is_single}, own.Dimensions);
if strcmp(own.Device, 'gpu')
    number = '';
    if ~isempty(own.DeviceNum)
        number = sprintf(' --device-num %d', own.DeviceNum);
    end
    command = strrep(command, ' 2>&1', [' --device gpu' number ' 2>&1']);
end
if ~isempty(own.Program)
    command = sprintf('SHEARWAKE=%s %s', quoted(own.Program), command);
end
if ~ispc && ~exist('OCTAVE_VERSION', 'builtin')
    command = ['LD_LIBRARY_PATH= ' command]; % libraries of MATLAB do not fit other programs
end
[code, text] = system(command);
if code ~= 0
    error('shearwake:failed', '%s', strtrim(text));
end
fprintf('%s', text);

% Values in the order of index.txt: name, cuboid, sizes.
lines = strsplit(strtrim(fileread(fullfile(folder, 'index.txt'))), sprintf('\n'));
results = struct();
for k = 1:numel(lines)
    words = strsplit(strtrim(lines{k}), ' ');
    id = fopen(fullfile(folder, sprintf('%d.bin', k)), 'r', 'ieee-le');
    values = fread(id, Inf, 'double');
    fclose(id);
    shape = cellfun(@str2double, words(3:end));
    values = reshape(values, [shape, ones(1, 2 - numel(shape))]);
    if is_single && ~recast
        values = single(values);
    end
    results(str2double(words{2})).(words{1}) = values;
end
if isfield(sensor, 'record') || numel(results) > 1
    sensor_data = results;
elseif isfield(sensor, 'mask') && size(sensor.mask, 1) == 2 * own.Dimensions && ismatrix(sensor.mask) && ~is_binary
    sensor_data = results;
else
    sensor_data = results.p;
end
end

function text = quoted(text)
% For the shell, in which only the quotation mark itself ends a quotation.
text = ['''' strrep(text, '''', '''\''''') ''''];
end

function rmdir_all(folder)
if exist('OCTAVE_VERSION', 'builtin')
    confirm_recursive_rmdir(false, 'local');
end
rmdir(folder, 's');
end
